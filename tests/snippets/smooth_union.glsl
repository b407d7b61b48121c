// Polynomial smooth minimum (Quilez) of sphere and box.
float k = 0.2;
float a = length(p - vec3(0.25, 0.3, 0.0)) - 0.45;
vec3 q = abs(p + vec3(0.2, 0.3, 0.0)) - 0.3;
float b = length(max(q, 0.0)) + min(max(q.x, max(q.y, q.z)), 0.0);
float h = clamp(0.5 + 0.5 * (b - a) / k, 0.0, 1.0);
return mix(b, a, h) - k * h * (1.0 - h);
