// Rectangles on the frame itself: glyphs, swatches and bars, in pixels from the upper left corner.
flat varying vec4 v_colour;
varying vec2 v_texel;

#ifdef VERTEX
layout(location = 0) in vec4 a_frame;       // left, top, right, bottom
layout(location = 1) in vec4 a_atlas;       // the same, in texels
layout(location = 2) in vec4 a_colour;
uniform vec2 u_frame;

void main() {
    vec2 corner = vec2(float(gl_VertexID & 1), float(gl_VertexID >> 1));
    vec2 pixel = mix(a_frame.xy, a_frame.zw, corner);
    v_colour = a_colour;
    v_texel = mix(a_atlas.xy, a_atlas.zw, corner);
    gl_Position = vec4(2.0 * pixel.x / u_frame.x - 1.0, 1.0 - 2.0 * pixel.y / u_frame.y, 0.0, 1.0);
}
#else
uniform sampler2D u_atlas;
out vec4 colour;

void main() {
    colour = vec4(v_colour.rgb, v_colour.a * texelFetch(u_atlas, ivec2(v_texel), 0).r);
}
#endif
