"""Soils: the catalogue, keywords, files."""

from __future__ import annotations

import copy
import pickle
from pathlib import Path

import pytest

from grouser import InputError, InputTypeError, soils

KEYS = {
    "name": "test bed",
    "n": 1.1,
    "k_c_kn_per_m_n1": 0.9,
    "k_phi_kn_per_m_n2": 1528.4,
    "cohesion_kpa": 1.0,
    "phi_deg": 30.0,
    "k_shear_m": 0.025,
    "c_1": 0.18,
    "c_2": 0.32,
}


def test_keywords_are_the_keys_of_a_file(tmp_path: Path) -> None:
    soil = soils.Soil(**KEYS)
    for key, value in KEYS.items():
        assert getattr(soil, key) == value
    path = tmp_path / "soil.toml"
    path.write_text(soil.to_toml())
    assert soils.read(path) == soil
    assert pickle.loads(pickle.dumps(soil)) == soil == copy.deepcopy(soil)


def test_every_soil_of_the_catalogue_is_found_or_names_what_is_missing() -> None:
    complete = 0
    for key in soils.keys():
        try:
            soil = soils.find(key)
            complete += 1
        except InputError as error:
            assert error.field in ("k_shear", "c_1", "c_2")
            soil = soils.find(key, k_shear_m=0.02, c_1=0.3, c_2=0.2)
        assert soil.key == key and soil.source
        assert pickle.loads(pickle.dumps(soil)) == soil
    assert complete >= 2


@pytest.mark.parametrize(
    ("change", "field", "kind"),
    [
        ({"n": 9.0}, "n", InputError),
        ({"n": float("nan")}, "n", InputError),
        ({"phi_deg": 95.0}, "phi_deg", InputError),
        ({"cohesion_kpa": -1.0}, "cohesion_kpa", InputError),
        ({"n": "1.1"}, "n", InputTypeError),
        ({"n": [1.1]}, "n", InputTypeError),
        ({"n": 10**30}, "n", InputTypeError),
        ({"name": 3}, "name", InputTypeError),
        ({"k_sheer_m": 0.1}, "k_sheer_m", InputError),
        ({"n": None}, "n", InputError),
        ({"shear": "sideways"}, "shear", InputError),
    ],
)
def test_a_bad_key_is_named(change: dict[str, object], field: str, kind: type[Exception]) -> None:
    with pytest.raises(kind) as caught:
        soils.Soil(**{**KEYS, **change})
    assert caught.value.field == field  # type: ignore[attr-defined]


def test_limits_are_reported_with_their_unit() -> None:
    with pytest.raises(InputError) as caught:
        soils.Soil(**{**KEYS, "k_shear_m": 50.0})
    error = caught.value
    assert (error.field, error.value, error.limit, error.unit) == ("k_shear_m", 50.0, (1e-6, 10.0), "m")


def test_an_unknown_soil_and_a_missing_file() -> None:
    with pytest.raises(InputError, match="dry-sand") as caught:
        soils.find("cheese")
    assert caught.value.field == "key" and caught.value.value == "cheese"
    with pytest.raises(FileNotFoundError):
        soils.read("/no/such/soil.toml")
    with pytest.raises(InputError, match=":1:"):
        soils.Soil.from_toml("n =")
