"""The physics of Trackride: from a configuration to a trajectory. Knows no viewer, no thread, no dialog."""

from model.config import Config, ConfigError, load_config
from model.simulate import simulate
from model.study import simulate_many
from model.trajectory import Trajectory

__all__ = ["Config", "ConfigError", "Trajectory", "load_config", "simulate", "simulate_many"]
