"""Shared fixtures."""

import pytest
import surepose


@pytest.fixture
def config() -> surepose.Config:
    return surepose.Config({"scenario.goal_x_m": 1.0, "scenario.goal_y_m": 0.5, "scenario.goal_heading_deg": 0.0})
