// Schwarz' P surface.
vec3 q = cos(p * 3.1415927);
return (q.x + q.y + q.z) / 5.5;
