// A body in the plane: a disc with an edge antialiased by its exact distance, and a thin outline.
flat varying vec4 v_colour;
flat varying float v_radius;        // pixels
varying vec2 v_place;               // pixels from the centre

#ifdef VERTEX
uniform float u_scale;              // pixels in the simulation's length
uniform float u_opacity;            // of images in a periodic box less than 1

void main() {
    vec2 size = visible_size(a_form.x * u_scale);
    vec4 clip = u_projection * vec4(eye_from_centre(place_now()), 1.0);
    v_colour = vec4(colour_now(), u_opacity * size.y);
    v_radius = size.x;
    v_place = (2.0 * corner_of_quad() - 1.0) * (size.x + 1.0);
    gl_Position = clip + vec4(2.0 * v_place / u_frame, 0.0, 0.0);
}
#else
uniform vec3 u_ground;
uniform vec3 u_ink;
out vec4 colour;

// Darker than the body; where the body is hard to tell from the ground, nearer to the ink instead.
vec3 outline_of(vec3 body) {
    vec3 luma = vec3(0.299, 0.587, 0.114);
    float contrast = abs(dot(luma, body - u_ground));
    return mix(mix(body, u_ink, 0.28), 0.55 * body, smoothstep(0.10, 0.30, contrast));
}

void main() {
    float inside = v_radius - length(v_place);
    float coverage = clamp(inside + 0.5, 0.0, 1.0);
    float width = min(1.25 * u_point, 0.22 * v_radius);
    float outline = clamp(width - inside + 0.5, 0.0, 1.0) * smoothstep(1.5, 4.0, v_radius / u_point);
    colour = vec4(mix(v_colour.rgb, outline_of(v_colour.rgb), outline), v_colour.a * coverage);
}
#endif
