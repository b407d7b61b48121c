// Infinite cone of half angle 30 degrees, its tip up (an upper and lower bound off the axis).
vec2 c = vec2(sin(radians(30.0)), cos(radians(30.0)));
vec2 q = vec2(length(p.xz), 0.6 - p.y);
float d = dot(q, vec2(c.y, -c.x));
return q.y < 0.0 && dot(q, c.yx) < 0.0 ? length(q) : d;
