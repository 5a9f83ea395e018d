"""Figures."""

from __future__ import annotations

import pickle
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import numpy as np
import pytest

from grouser import InputError, InputTypeError, figures, soils
from grouser.wheel import Wheel


def test_a_figure_is_valid_svg_and_shows_its_lines(tmp_path: Path) -> None:
    wheel = Wheel(radius_m=0.125, width_m=0.1)
    figure = figures.slip_curves(soils.find("dry-sand"), wheel, load_n=[40.0, 80.0])
    assert ElementTree.fromstring(figure._repr_svg_()).tag.endswith("svg")
    one = figures.slip_curves(soils.find("dry-sand"), wheel, load_n=80.0)
    assert one.svg.count("<path") < figure.svg.count("<path")
    figure.write(tmp_path / "figure.svg")
    assert (tmp_path / "figure.svg").read_text() == figure.svg
    assert pickle.loads(pickle.dumps(figure)) == figure


def test_a_figure_is_written_as_a_whole_or_not_at_all(tmp_path: Path) -> None:
    figure = figures.lines("t", "x", "y", figures.Line([0.0, 1.0], [0.0, 1.0]))
    path = tmp_path / "figure.svg"
    path.write_text("old")
    path.chmod(0o444)
    with pytest.raises(PermissionError, match="figure.svg"):
        figure.write(path)
    assert path.read_text() == "old"
    path.chmod(0o640)
    figure.write(path)
    assert path.read_text() == figure.svg
    assert path.stat().st_mode & 0o777 == 0o640
    folder = tmp_path / "folder.svg"
    folder.mkdir()
    with pytest.raises(IsADirectoryError):
        figure.write(folder)
    folder.rmdir()
    with pytest.raises(FileNotFoundError):
        figure.write(tmp_path / "none" / "figure.svg")
    assert [file.name for file in tmp_path.iterdir()] == ["figure.svg"]


def test_titles_are_text_not_markup() -> None:
    figure = figures.lines("<script>", "x", "y", figures.Line([0.0, 1.0], [0.0, np.nan]), figures.Line([0.5], [0.5], points=True))
    assert "<script>" not in figure.svg
    ElementTree.fromstring(figure.svg)


def test_what_cannot_be_drawn_is_said() -> None:
    wheel = Wheel(radius_m=0.125, width_m=0.1)
    for loads, value in (([40.0, -1.0], -1.0), (1e9, 1e9), ([], 0)):
        with pytest.raises(InputError) as caught:
            figures.slip_curves(soils.find("dry-sand"), wheel, load_n=loads)
        assert (caught.value.field, caught.value.value) == ("load_n", value)
    with pytest.raises(InputError) as caught:
        figures.slip_curves(soils.find("dry-sand"), wheel, load_n=np.nan)
    assert caught.value.field == "load_n"
    figure = figures.slip_curves(soils.find("dry-sand"), wheel, load_n=40.0)
    assert "<title>Dry sand: drawbar_pull_n against slip</title>" in figure.svg
    for field, label, title in (("label", "\ud800", "a"), ("title", "", "\udfff")):
        with pytest.raises(InputError) as caught:
            figures.lines(title, "x", "y", figures.Line([0.0], [0.0], label))
        assert caught.value.field == field and str(caught.value).startswith(field)
    with pytest.raises(InputTypeError) as wrong:
        figures.lines("a", "x", "y", figures.Line([0.0], [0.0], 3))  # type: ignore[arg-type]
    assert wrong.value.field == "label"


def test_columns_of_different_lengths_are_refused() -> None:
    with pytest.raises(InputError) as caught:
        figures.lines("a", "x", "y", figures.Line([0.0, 1.0], [0.0]))
    assert caught.value.field == "y"
    with pytest.raises(InputError):
        figures.slip_curves(soils.find("lunar"), Wheel(radius_m=0.1, width_m=0.1), load_n=50.0, quantity="colour")


def test_a_figure_is_svg_or_png_and_no_other_file(tmp_path: Path) -> None:
    figure = figures.lines("Pull", "x", "y", figures.Line([0.0, 1.0], [0.0, 1.0]))
    for name in ("x.pdf", "x", "x.svg.jpg"):
        with pytest.raises(InputError, match=r"must end in `\.svg` or `\.png`") as caught:
            figure.write(tmp_path / name)
        assert caught.value.field == "path" and not (tmp_path / name).exists()
    figure.write(tmp_path / "X.SVG")
    assert (tmp_path / "X.SVG").read_text() == figure.svg
    sizes = []
    for dots_per_inch in (100.0, 200.0):
        figure.write(tmp_path / "x.png", dots_per_inch=dots_per_inch)
        picture = (tmp_path / "x.png").read_bytes()
        assert picture.startswith(b"\x89PNG\r\n")
        sizes.append(int.from_bytes(picture[16:20], "big"))
    assert abs(sizes[1] - 2 * sizes[0]) <= 2
    with pytest.raises(InputError) as caught:
        figure.write(tmp_path / "large.png", dots_per_inch=1e9)
    assert caught.value.field == "dots_per_inch" and not (tmp_path / "large.png").exists()
