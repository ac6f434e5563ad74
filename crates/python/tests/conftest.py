"""Where the bundled data are."""

from pathlib import Path

import pytest


@pytest.fixture(scope="session")
def fixtures() -> Path:
    return Path(__file__).resolve().parents[3] / "fixtures"
