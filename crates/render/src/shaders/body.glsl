// A body with its own clock: it is moved to the scene's time here, so that nobody else has to touch it.
#ifdef VERTEX
layout(location = 0) in vec4 a_high;        // position and time
layout(location = 1) in vec4 a_low;
layout(location = 2) in vec3 a_velocity;
layout(location = 3) in vec2 a_form;        // radius, shade

uniform vec3 u_field;           // acceleration
uniform int u_reading;          // what is read: the shade 0, the speed 1, the kinetic energy of the mass in the shade 2, a height 3
uniform vec3 u_up;              // direction of the height
uniform int u_continuous;       // the shade is a place on the colour map; otherwise the number of a colour
uniform vec2 u_range;           // least, and one over the extent
uniform vec3 u_map[11];
uniform int u_colours;          // how many of them are in use

// x(t) - x(t_i) = v (t - t_i) + g (t - t_i)^2 / 2
vec3 displacement_now() {
    float dt = elapsed_since(vec2(a_high.w, a_low.w));
    return (a_velocity + 0.5 * dt * u_field) * dt;
}

// Relative to the camera's centre.
vec3 place_now() {
    return from_centre(a_high.xyz, a_low.xyz) + displacement_now();
}

vec3 colour_now() {
    float shade = a_form.y;
    if (u_reading == 3) {
        shade = dot(a_high.xyz + displacement_now(), u_up);
    } else if (u_reading > 0) {
        vec3 v = a_velocity + elapsed_since(vec2(a_high.w, a_low.w)) * u_field;
        shade = u_reading == 1 ? length(v) : 0.5 * shade * dot(v, v);
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
