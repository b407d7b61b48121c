// Every way to round.
vec3 q = p * 2.7;
float s = floor(q.x) + ceil(q.y) - trunc(q.z) + fract(q.x * 0.5);
return 0.1 * s + 0.2 * (p.x + p.y - p.z) - 0.05;
