// Two strands and their rungs, turning with time.
float a = 5.0 * p.y + 0.001 * t;
vec2 axis = vec2(cos(a), sin(a));
float along = dot(p.xz, axis), across = dot(p.xz, vec2(-axis.y, axis.x));
float strands = length(vec2(abs(along) - 0.4, across)) - 0.1;
float rung = length(vec2(across, mod(p.y, 0.25) - 0.125)) - 0.03;
rung = max(rung, abs(along) - 0.4);
return 0.4 * min(strands, rung);
