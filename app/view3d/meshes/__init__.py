"""Meshes made with trimesh, to the measures of the vehicle that is shown."""
