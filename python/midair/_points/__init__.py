"""Points and meshes: files of pictures and 3D models, quiet boxes at ears, and the sound on meshes."""
