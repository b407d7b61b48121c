// An arc of a torus, with round ends (Quilez, "Capped Torus").
vec2 sc = vec2(sin(2.2), cos(2.2));
vec3 q = vec3(abs(p.x), p.y, p.z);
float k = (sc.y * q.x > sc.x * q.y) ? dot(q.xy, sc) : length(q.xy);
return sqrt(dot(q, q) + 0.36 - 1.2 * k) - 0.15;
