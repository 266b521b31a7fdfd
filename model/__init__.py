"""The physics of Trackride: from a configuration to a trajectory. Knows no viewer, no thread, no dialog."""

from model.config.config import Config, ConfigError
from model.config.config_files import load_config
from model.simulation.batch import simulate_many
from model.simulation.simulate import simulate
from model.simulation.trajectory import Trajectory

__all__ = ["Config", "ConfigError", "Trajectory", "load_config", "simulate", "simulate_many"]
