// Schoen's gyroid, thickened to a wall; scaled to be a lower bound near the surface.
vec3 q = p * 6.0;
float g = dot(sin(q), cos(q.yzx));
return (abs(g) - 0.4) / 11.0;
