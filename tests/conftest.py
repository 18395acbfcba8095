from hypothesis import settings

# No test is timed: a busy machine is not a bug.
settings.register_profile("untimed")
settings.load_profile("untimed")
