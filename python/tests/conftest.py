"""Cases of the tests: the bar of the recipes, pulled apart in motion, and the same bar at rest."""

import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "python" / "examples"))

import stop_at_crack  # noqa: E402


@pytest.fixture
def breaking(tmp_path):
    """A bar that breaks within 1 ms: damage, removed elements, discrete elements."""
    return stop_at_crack.write_case(tmp_path / "breaking")


@pytest.fixture
def elastic(tmp_path):
    """The bar without damage, held at one end."""
    case = stop_at_crack.write_case(tmp_path / "elastic")
    text = stop_at_crack.CASE
    supports = text[text.index("supports") : text.index("solver")]
    damage = text[text.index("[materials.concrete.damage]") : text.index("[parameters]")]
    text = text.replace(damage, "").replace(supports, 'supports = [{ group = "x-", fix = "xyz" }]\n')
    case.write_text(text.replace('reaction = { group = "x+"', 'reaction = { group = "x-"'))
    return case


@pytest.fixture
def resting(elastic):
    """The bar at rest, pulled by 0.1 mm."""
    pulled = '{ group = "x+", displacement = { x = "0.1 mm * t / 1 s" } }]'
    text = elastic.read_text().replace('fix = "xyz" }]', f'fix = "xyz" }}, {pulled}')
    text = text.replace('kind = "explicit", end = "2 ms"', 'kind = "static", end = "1 s"')
    elastic.write_text(text[: text.index("output")] + text[text.index("[materials") :])
    return elastic


@pytest.fixture
def ball():
    """A loose particle that slides off a rigid plane, from the gallery."""
    return ROOT / "cases" / "chung-ooi" / "oblique.toml"
