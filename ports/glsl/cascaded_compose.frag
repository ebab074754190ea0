#version 330
// Cascaded layers, the picture: the front buffer over the back buffer, which ends with the layer in focus.
// Divided by alpha.
//
// Source: Schedl & Wimmer (2012), A Layered Depth-of-Field Method for Solving Partial Occlusion, equation (12).

uniform sampler2D uFront;  // premultiplied
uniform sampler2D uBack;   // premultiplied

layout(location = 0) out vec4 result;     // linear RGB
layout(location = 1) out vec4 composite;  // premultiplied

void main()
{
    ivec2 here = ivec2(gl_FragCoord.xy);
    vec4 front = texelFetch(uFront, here, 0);
    composite = front + (1.0 - front.a) * texelFetch(uBack, here, 0);
    result = vec4(composite.a > 0.0 ? composite.rgb / composite.a : composite.rgb, 1.0);
}
