// Four slanted half spaces and a floor.
float slope = 0.8, side = inversesqrt(1.0 + slope * slope);
vec2 q = abs(p.xz);
float wall = (max(q.x, q.y) + (p.y - 0.6) * slope) * side;
return max(wall, -0.6 - p.y);
