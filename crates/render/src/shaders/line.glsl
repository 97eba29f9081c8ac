// A straight line with round ends and a constant width on the screen.
flat varying vec4 v_colour;
flat varying vec2 v_form;           // length and half the width, in pixels
varying vec2 v_place;               // along the line from its start, and across, in pixels

#ifdef VERTEX
layout(location = 0) in vec3 a_from_high;
layout(location = 1) in vec3 a_from_low;
layout(location = 2) in vec3 a_to_high;
layout(location = 3) in vec3 a_to_low;
layout(location = 4) in float a_width;
layout(location = 5) in vec4 a_colour;
uniform float u_near;

void main() {
    vec3 from = eye_from_centre(from_centre(a_from_high, a_from_low));
    vec3 to = eye_from_centre(from_centre(a_to_high, a_to_low));
    if (from.z > -u_near && to.z > -u_near) {
        gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
        return;
    }
    // What is behind the eye is cut off before the division by depth.
    if (from.z > -u_near) {
        from = mix(to, from, (-u_near - to.z) / (from.z - to.z));
    } else if (to.z > -u_near) {
        to = mix(from, to, (-u_near - from.z) / (to.z - from.z));
    }
    vec4 clip_from = u_projection * vec4(from, 1.0);
    vec4 clip_to = u_projection * vec4(to, 1.0);
    vec2 pixel_from = pixel_from_clip(clip_from);
    vec2 way = pixel_from_clip(clip_to) - pixel_from;
    float length_ = length(way);
    vec2 along = length_ > 0.0 ? way / length_ : vec2(1.0, 0.0);
    vec2 corner = corner_of_quad();
    float half_width = 0.5 * a_width * u_point;
    float margin = half_width + 1.0;
    v_colour = a_colour;
    v_form = vec2(length_, half_width);
    v_place = vec2(mix(-margin, length_ + margin, corner.x), mix(-margin, margin, corner.y));
    vec2 pixel = pixel_from + v_place.x * along + v_place.y * vec2(-along.y, along.x);
    float depth = corner.x < 0.5 ? clip_from.z / clip_from.w : clip_to.z / clip_to.w;
    gl_Position = vec4(2.0 * pixel / u_frame - 1.0, depth, 1.0);
}
#else
out vec4 colour;

void main() {
    float beyond = max(max(-v_place.x, v_place.x - v_form.x), 0.0);
    float distance = length(vec2(beyond, v_place.y));
    // A line thinner than a pixel is a pixel wide and paler.
    float coverage = clamp(v_form.y - distance + 0.5, 0.0, min(1.0, 2.0 * v_form.y));
    colour = vec4(v_colour.rgb, v_colour.a * coverage);
}
#endif
