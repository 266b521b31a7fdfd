"""What the 3-D view is built of: meshes made with trimesh, to the measures of the vehicle that is shown."""
