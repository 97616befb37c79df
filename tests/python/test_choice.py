"""What the choice of `auto` costs."""

from pathlib import Path

import pytest

SCRIPTS = Path(__file__).resolve().parents[2] / "scripts"


@pytest.mark.skipif(not SCRIPTS.exists(), reason="the scripts are not here")
def test_the_choice_costs_little_on_held_out_holes(monkeypatch):
    """Error of what auto chose over that of the best candidate: patches continue a sphere exactly, splines know a hill better."""
    pytest.importorskip("scipy")
    monkeypatch.syspath_prepend(str(SCRIPTS))
    known = __import__("known_holes")
    found = []
    for hole in known.known_holes(31, spacings=(0.16,), surfaces=("sphere", "hill")):
        each = known.regret({method: hole.error(fill) for method, fill in hole.fills().items()})
        found += [] if each is None else [each]
    mean, worst = known.summary(found)
    assert len(found) > 15
    assert mean < 1.15
    assert worst < 8
