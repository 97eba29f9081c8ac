// A filled rectangle in the plane z = 0.
flat varying vec4 v_colour;

#ifdef VERTEX
layout(location = 0) in vec4 a_high;        // lower and upper corner
layout(location = 1) in vec4 a_low;
layout(location = 2) in vec4 a_colour;

void main() {
    vec2 corner = corner_of_quad();
    vec2 high = mix(a_high.xy, a_high.zw, corner);
    vec2 low = mix(a_low.xy, a_low.zw, corner);
    v_colour = a_colour;
    gl_Position = u_projection * vec4(eye_from_centre(from_centre(vec3(high, 0.0), vec3(low, 0.0))), 1.0);
}
#else
out vec4 colour;

void main() {
    colour = v_colour;
}
#endif
