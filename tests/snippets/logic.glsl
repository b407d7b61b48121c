// Conditions combined with and, or, exclusive or, not; a choice by mix over booleans.
bool a = p.x > 0.0, b = p.y > 0.1, c = p.z > -0.2;
bool inside = (a && b) || (b ^^ c) && !a;
bvec2 both = greaterThan(p.xy, p.yz);
vec2 chosen = mix(p.xy, p.yz, both);
float d = length(chosen) - 0.5;
return inside ? d : d + 0.1 * float(any(both)) + 0.05;
