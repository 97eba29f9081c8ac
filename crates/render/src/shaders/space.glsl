// From the simulation's space to the frame. A coordinate comes as two floats whose sum holds 48 bits (`pair` in Rust);
// the camera's centre is subtracted part by part, so that the small difference of two large numbers stays exact.
uniform mat4 u_projection;      // eye space to clip space
uniform vec2 u_frame;           // width and height in pixels
uniform float u_point;          // pixels in a point

#ifdef VERTEX
uniform vec3 u_centre_high;
uniform vec3 u_centre_low;
uniform mat3 u_rotation;
uniform float u_distance;       // from the eye to the camera's centre; 0 in the plane
uniform vec2 u_time;            // the scene's, as a pair

vec3 from_centre(vec3 high, vec3 low) {
    return (high - u_centre_high) + (low - u_centre_low);
}

vec3 eye_from_centre(vec3 place) {
    return u_rotation * place - vec3(0.0, 0.0, u_distance);
}

float elapsed_since(vec2 time) {
    return (u_time.x - time.x) + (u_time.y - time.y);
}

// Pixels from the lower left corner.
vec2 pixel_from_clip(vec4 clip) {
    return (clip.xy / clip.w * 0.5 + 0.5) * u_frame;
}

vec2 corner_of_quad() {
    return vec2(float(gl_VertexID & 1), float(gl_VertexID >> 1));
}
#endif
