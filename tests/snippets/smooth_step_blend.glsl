// Two shapes faded along x by smoothstep.
float s = smoothstep(-0.5, 0.5, p.x);
float ball = length(p) - 0.6;
float slab = abs(p.y) - 0.3;
return mix(ball, slab, s);
