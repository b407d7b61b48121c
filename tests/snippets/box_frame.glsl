// The twelve edges of a box, each a thin box (Quilez, "Box Frame").
float e = 0.08;
vec3 a = abs(p) - vec3(0.7);
vec3 q = abs(a + e) - e;
float x = length(max(vec3(a.x, q.y, q.z), 0.0)) + min(max(a.x, max(q.y, q.z)), 0.0);
float y = length(max(vec3(q.x, a.y, q.z), 0.0)) + min(max(q.x, max(a.y, q.z)), 0.0);
float z = length(max(vec3(q.x, q.y, a.z), 0.0)) + min(max(q.x, max(q.y, a.z)), 0.0);
return min(min(x, y), z);
