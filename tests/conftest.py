from hypothesis import settings

# No test is timed: a busy machine is not a bug.
settings.register_profile("untimed", deadline=None)
settings.load_profile("untimed")
