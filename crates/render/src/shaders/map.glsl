// A rectangle in the plane z = 0, coloured cell by cell.
varying vec2 v_place;           // from (0, 0) at the lower corner to (1, 1) at the upper one

#ifdef VERTEX
layout(location = 0) in vec4 a_high;        // lower and upper corner
layout(location = 1) in vec4 a_low;

void main() {
    v_place = corner_of_quad();
    vec2 high = mix(a_high.xy, a_high.zw, v_place);
    vec2 low = mix(a_low.xy, a_low.zw, v_place);
    gl_Position = u_projection * vec4(eye_from_centre(from_centre(vec3(high, 0.0), vec3(low, 0.0))), 1.0);
}
#else
uniform sampler2D u_cells;
out vec4 colour;

void main() {
    colour = texture(u_cells, v_place);
}
#endif
