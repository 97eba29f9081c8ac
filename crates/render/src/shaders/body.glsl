// A body with its own clock: it is moved to the scene's time here, so that nobody else has to touch it.
#ifdef VERTEX
layout(location = 0) in vec4 a_high;        // position and time
layout(location = 1) in vec4 a_low;
layout(location = 2) in vec3 a_velocity;
layout(location = 3) in vec2 a_form;        // radius, shade

uniform vec3 u_field;           // acceleration
uniform int u_by_speed;         // the shade is the speed
uniform int u_continuous;       // the shade is a place on the colour map; otherwise the number of a colour
uniform vec2 u_range;           // least, and one over the extent
uniform vec3 u_map[11];
uniform int u_colours;          // how many of them are in use

// x(t) = x + v (t - t_i) + g (t - t_i)^2 / 2, relative to the camera's centre.
vec3 place_now() {
    float dt = elapsed_since(vec2(a_high.w, a_low.w));
    return from_centre(a_high.xyz, a_low.xyz) + (a_velocity + 0.5 * dt * u_field) * dt;
}

vec3 colour_now() {
    float shade = a_form.y;
    if (u_by_speed == 1) {
        shade = length(a_velocity + elapsed_since(vec2(a_high.w, a_low.w)) * u_field);
    }
    if (u_continuous == 0) {
        return u_map[int(max(shade, 0.0) + 0.5) % u_colours];
    }
    float knot = clamp((shade - u_range.x) * u_range.y, 0.0, 1.0) * float(u_colours - 1);
    int below = min(int(knot), u_colours - 2);
    return mix(u_map[below], u_map[below + 1], knot - float(below));
}

// Radius drawn, in pixels, and opacity. The scene may ask for a smallest radius. Where it does not, bodies smaller than a
// pixel are drawn as large as one and paler, so that a crowd keeps its mean brightness; one without extent is a mark and
// stays opaque.
uniform float u_least_radius;       // points

vec2 visible_size(float radius) {
    radius = max(radius, u_least_radius * u_point);
    float least = 0.75 * u_point;
    float part = radius / least;
    return vec2(max(radius, least), radius > 0.0 ? clamp(part * part, 0.2, 1.0) : 1.0);
}
#endif
