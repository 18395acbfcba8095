import pickle

import numpy as np
import pytest
import torch
from safetensors.torch import save_file

from sketchwidget.avatar.stylegan import Generator, load_generator, picture, project, swap_layers
from sketchwidget.avatar.stylize import StyleGanStylizer
from sketchwidget.portrait import FaceLandmarks


def generator(seed=0):
    torch.manual_seed(seed)
    return Generator(style=16, mapping=2, channels=[16, 16, 8, 8]).eval()


@pytest.fixture(scope="module")
def states():
    return generator(0).state_dict(), generator(1).state_dict()


def test_parameters_are_named_as_in_checkpoints(states):
    """Names and shapes of stylegan2-pytorch, written out for a generator of 8 pixels."""
    small = Generator(style=4, mapping=1, channels=[6, 5]).state_dict()
    expected = {"style.1.weight": (4, 4), "style.1.bias": (4,), "input.input": (1, 6, 4, 4)}
    for name, sizes in {"conv1": (6, 6), "convs.0": (6, 5), "convs.1": (5, 5)}.items():
        below, here = sizes
        expected |= {f"{name}.conv.weight": (1, here, below, 3, 3), f"{name}.noise.weight": (1,)}
        expected |= {f"{name}.activate.bias": (here,), f"{name}.conv.modulation.weight": (below, 4)}
        expected |= {f"{name}.conv.modulation.bias": (below,)}
    for name, below in {"to_rgb1": 6, "to_rgbs.0": 5}.items():
        expected |= {f"{name}.conv.weight": (1, 3, below, 1, 1), f"{name}.bias": (1, 3, 1, 1)}
        expected |= {f"{name}.conv.modulation.weight": (below, 4), f"{name}.conv.modulation.bias": (below,)}
    expected |= {"convs.0.conv.blur.kernel": (4, 4), "to_rgbs.0.upsample.kernel": (4, 4)}
    expected |= {"noises.noise_0": (1, 1, 4, 4), "noises.noise_1": (1, 1, 8, 8), "noises.noise_2": (1, 1, 8, 8)}
    assert {name: tuple(value.shape) for name, value in small.items()} == expected


def test_doubling_keeps_what_is_constant(states):
    to_rgb = Generator.of(states[0]).to_rgbs[0]
    with torch.no_grad():
        to_rgb.conv.weight.zero_()
        to_rgb.bias.zero_()
        doubled = to_rgb(torch.zeros(1, 16, 8, 8), torch.zeros(1, 16), torch.ones(1, 3, 4, 4))
    assert torch.allclose(doubled[..., 2:-2, 2:-2], torch.ones(1, 3, 4, 4), atol=1e-6)


@pytest.mark.parametrize("suffix", ["pt", "safetensors"])
def test_checkpoints_are_read_back(states, tmp_path, suffix):
    path = tmp_path / f"generator.{suffix}"
    if suffix == "pt":
        torch.save({"g_ema": states[0], "latent_avg": torch.zeros(16)}, path)
    else:
        save_file({name: value.contiguous() for name, value in states[0].items()}, path)
    read = Generator.of(load_generator(path))
    codes = torch.randn(1, read.codes, 16)
    with torch.no_grad():
        assert torch.allclose(read(codes), Generator.of(states[0])(codes))
        assert read(codes).shape == (1, 3, 32, 32)


class Evil:
    def __reduce__(self):
        return (print, ("this ran",))


def test_pickles_are_refused_and_nothing_runs(tmp_path, capsys):
    network, other = tmp_path / "network.pkl", tmp_path / "network.pt"
    network.write_bytes(pickle.dumps(Evil()))
    torch.save({"g_ema": Evil()}, other)
    with pytest.raises(ValueError, match="convert_weight"):
        load_generator(network)
    with pytest.raises(ValueError, match="more than tensors"):
        load_generator(other)
    assert "this ran" not in capsys.readouterr().out


def test_checkpoints_of_another_kind_or_size_are_told(states, tmp_path):
    with pytest.raises(ValueError, match="no StyleGAN2 generator"):
        Generator.of({"weight": torch.zeros(3)})
    with pytest.raises(ValueError, match="no StyleGAN2 generator"):
        Generator.of({name: value for name, value in states[0].items() if name != "conv1.activate.bias"})
    larger = Generator(style=16, mapping=2, channels=[16, 16, 8, 8, 4]).state_dict()
    with pytest.raises(ValueError, match="one size"):
        swap_layers(states[0], larger, 8)
    with pytest.raises(ValueError, match="resolution"):
        swap_layers(*states, 12)
    with pytest.raises(FileNotFoundError):
        load_generator(tmp_path / "none.pt")


def test_swapping_takes_the_coarse_layers(states):
    """The features up to a resolution are the other's, and those after it the base's."""
    base, other = states
    mixed = swap_layers(base, other, 8)
    for name in ("input.input", "conv1.conv.weight", "convs.1.conv.weight", "to_rgbs.0.bias", "noises.noise_2"):
        assert mixed[name] is other[name], name
    for name in ("style.1.weight", "convs.2.conv.weight", "to_rgbs.1.bias", "noises.noise_3"):
        assert mixed[name] is base[name], name
    assert all(
        mixed_all is one for mixed_all, one in zip(swap_layers(base, base, 16).values(), base.values(), strict=True)
    )


def test_projection_comes_near_to_a_picture_of_the_generator(states):
    made = Generator.of(states[0])
    torch.manual_seed(5)
    wanted = picture(made, made.style(torch.randn(1, 16)).expand(made.codes, -1).detach())
    start = picture(made, made.mean_code().expand(made.codes, -1))
    found = picture(made, project(made, wanted, steps=80))
    error = [np.abs(image.astype(float) - wanted).mean() for image in (start, found)]
    assert error[1] < 0.5 * error[0]


def test_the_stylizer_looks_for_the_face_in_what_it_drew(states):
    points = np.random.default_rng(0).uniform(10, 50, (68, 2))

    class Detector:
        def __init__(self, boxes):
            self.boxes = boxes

        def faces(self, image):
            return self.boxes

        def landmarks(self, image, box):
            return FaceLandmarks(points + len(image))

    image = np.zeros((64, 64, 3), np.uint8)
    made = StyleGanStylizer(*states, 8, Detector(np.ones((1, 4))), steps=2)(image, FaceLandmarks(points))
    assert made.image.shape == (64, 64, 3) and np.array_equal(made.marks.points, points + 64)
    with pytest.raises(ValueError, match="no face"):
        StyleGanStylizer(*states, 8, Detector(np.zeros((0, 4))), steps=2)(image, FaceLandmarks(points))
