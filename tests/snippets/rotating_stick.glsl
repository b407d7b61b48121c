// A capsule that turns around z, once in four seconds.
float angle = t / 4000.0 * 6.2831853;
vec2 d = vec2(cos(angle), sin(angle));
float h = clamp(dot(p.xy, d), -0.6, 0.6);
return length(vec3(p.xy - h * d, p.z)) - 0.1;
