// Depth alone is wanted: of the shadow map, and of what the eye sees.
void main() {}
