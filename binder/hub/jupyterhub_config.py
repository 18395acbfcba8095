"""A hub that gives every pupil a container of the image, on the machine that it runs on.

    pip install 'jupyterhub==6.*' dockerspawner jupyterhub-idle-culler; npm install -g configurable-http-proxy
    jupyterhub -f binder/hub/jupyterhub_config.py

Whoever has an account on the machine may log in; others by another `JupyterHub.authenticator_class`.
"""

import sys

c = get_config()  # noqa: F821  # a name that JupyterHub gives to what it reads

c.Authenticator.allow_all = True  # without this JupyterHub lets nobody in
c.JupyterHub.spawner_class = "dockerspawner.DockerSpawner"
c.JupyterHub.hub_ip = "0.0.0.0"  # containers reach the hub from a network of their own, by a name that Docker gives
c.DockerSpawner.hub_connect_url = "http://host.docker.internal:8081"
c.DockerSpawner.extra_host_config = {"extra_hosts": {"host.docker.internal": "host-gateway"}}
c.DockerSpawner.image = "sketchwidget-hub"
c.DockerSpawner.remove = True
c.DockerSpawner.volumes = {"sketchwidget-{username}": "/home/pupil"}  # what is drawn and written outlives the container
c.DockerSpawner.notebook_dir = "/home/pupil"
c.DockerSpawner.default_url = "/lab/tree/course/00_studio.ipynb"

# A kernel with a Studio and its server take under 0.8 GB (benchmarks/HUB.md): room for a second notebook.
c.DockerSpawner.mem_limit = "2G"
c.DockerSpawner.cpu_limit = 1.0

# A class logs in all at once, and each server takes seconds of a processor to start.
c.DockerSpawner.start_timeout = 300
c.DockerSpawner.http_timeout = 300

# What nobody has used for an hour gives its memory back; the volume keeps what was drawn.
c.JupyterHub.services = [
    {"name": "idle-culler", "command": [sys.executable, "-m", "jupyterhub_idle_culler", "--timeout=3600"]}
]
c.JupyterHub.load_roles = [
    {
        "name": "idle-culler",
        "services": ["idle-culler"],
        "scopes": ["list:users", "read:users:activity", "read:servers", "delete:servers"],
    }
]
