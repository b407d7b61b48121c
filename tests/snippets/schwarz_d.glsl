// Schwarz' D surface.
vec3 s = sin(p * 4.0), c = cos(p * 4.0);
return (s.x * s.y * s.z + s.x * c.y * c.z + c.x * s.y * c.z + c.x * c.y * s.z) / 8.0;
