"""What the 3-D view is built of: meshes, to the measures of the vehicle that is shown."""
