// A path as one strip: two vertices a point, read from a ring of points that stays in the graphics memory.
varying float v_across;             // from -1 to 1
varying float v_opacity;

#ifdef VERTEX
uniform sampler2D u_ring;           // two texels a point: the high parts of x, y, z, t, and the low ones
uniform int u_row;                  // points in a row of it
uniform int u_capacity;
uniform int u_first;                // slot of the oldest point
uniform int u_points;
uniform vec2 u_oldest;              // its time, as a pair
uniform float u_half_width;         // pixels, with the margin

vec4 clip_of(int point, out float age) {
    int slot = (u_first + clamp(point, 0, u_points - 1)) % u_capacity;
    ivec2 texel = ivec2(2 * (slot % u_row), slot / u_row);
    vec4 high = texelFetch(u_ring, texel, 0);
    vec4 low = texelFetch(u_ring, texel + ivec2(1, 0), 0);
    age = elapsed_since(vec2(high.w, low.w));
    return u_projection * vec4(eye_from_centre(from_centre(high.xyz, low.xyz)), 1.0);
}

vec2 direction(vec2 way) {
    float size = length(way);
    return size > 1e-3 ? way / size : vec2(0.0);
}

void main() {
    int point = gl_VertexID >> 1;
    float side = float(2 * (gl_VertexID & 1) - 1);
    float age;
    float unused;
    vec4 clip = clip_of(point, age);
    vec2 here = pixel_from_clip(clip);
    vec2 before = direction(here - pixel_from_clip(clip_of(point - 1, unused)));
    vec2 after = direction(pixel_from_clip(clip_of(point + 1, unused)) - here);
    // Neighbours share the edge between them (a mitre), so that no part is painted twice; at sharp turns it is cut short.
    vec2 along = direction(before + after);
    if (along == vec2(0.0)) {
        along = before == vec2(0.0) ? vec2(1.0, 0.0) : before;
    }
    vec2 leg = before == vec2(0.0) ? after : before;
    float mitre = 1.0 / max(abs(dot(along, leg)), 0.5);
    vec2 offset = side * u_half_width * mitre * vec2(-along.y, along.x);
    float oldest = elapsed_since(u_oldest);
    v_across = side;
    v_opacity = pow(clamp(1.0 - age / max(oldest, 1e-30), 0.0, 1.0), 1.4);
    gl_Position = vec4(clip.xy + 2.0 * offset / u_frame * clip.w, clip.zw);
}
#else
uniform vec4 u_colour;
uniform float u_half_width;
out vec4 colour;

void main() {
    // The strip is half a pixel wider than the line on each side.
    float coverage = clamp(u_half_width * (1.0 - abs(v_across)), 0.0, 1.0);
    colour = vec4(u_colour.rgb, u_colour.a * v_opacity * coverage);
}
#endif
