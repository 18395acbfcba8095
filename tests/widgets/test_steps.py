from sketchwidget.widgets.steps import KEPT, Steps


def test_of_many_steps_the_last_can_be_taken_back():
    steps = Steps(0)
    for value in range(1, KEPT + 8):
        steps.go_to(value)
    while steps.undo():
        pass
    assert steps.present == 7
    while steps.redo():
        pass
    assert steps.present == KEPT + 7


def test_what_is_heavy_is_forgotten_but_never_the_present():
    steps = Steps("", lambda values: sum(map(len, values)) <= 6)
    for value in ("aa", "bb", "cccc"):
        steps.go_to(value)
    assert steps.undo() and steps.present == "bb" and not steps.undo()
    steps.go_to("d" * 100)
    assert steps.present == "d" * 100 and not steps.can_undo and not steps.can_redo


def test_after_an_undo_another_step_takes_the_place_of_what_was_undone():
    steps = Steps(1)
    steps.go_to(2)
    steps.undo()
    steps.go_to(3)
    assert steps.present == 3 and not steps.can_redo and steps.undo() and steps.present == 1
