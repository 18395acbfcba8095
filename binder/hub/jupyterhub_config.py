"""A hub that gives every pupil a container of the image, on the machine that it runs on.

    pip install jupyterhub==6.* dockerspawner, npm install -g configurable-http-proxy
    jupyterhub -f binder/hub/jupyterhub_config.py

Who may log in is another matter: `JupyterHub.authenticator_class`, by default the machine's own users.
"""

c = get_config()  # noqa: F821  # a name that JupyterHub gives to what it reads

c.JupyterHub.spawner_class = "dockerspawner.DockerSpawner"
c.JupyterHub.hub_ip = "0.0.0.0"  # containers reach the hub from a network of their own
c.DockerSpawner.image = "sketchwidget-hub"
c.DockerSpawner.remove = True
c.DockerSpawner.volumes = {"sketchwidget-{username}": "/home/pupil"}  # what is drawn and written outlives the container
c.DockerSpawner.notebook_dir = "/home/pupil"
c.DockerSpawner.default_url = "/lab/tree/course/00_studio.ipynb"

# A kernel with a Studio and its server take under 0.8 GB (benchmarks/HUB.md): room for a second notebook.
c.DockerSpawner.mem_limit = "2G"
c.DockerSpawner.cpu_limit = 1.0
