// Two metaballs that join and separate, t in milliseconds.
float reach = 0.45 * sin(t / 1000.0);
vec3 a = p - vec3(reach, 0.0, 0.0), b = p + vec3(reach, 0.0, 0.0);
float field = 0.1 / max(dot(a, a), 1e-4) + 0.1 / max(dot(b, b), 1e-4);
return 0.5 * (inversesqrt(field) - 0.6);
