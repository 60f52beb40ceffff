// Ambient occlusion in an OpenGL program by the shaders of a kit: draws boxes and spheres on a floor, computes the
// occlusion of its own depth buffer, and multiplies the picture by it. OpenGL 4.3 and EGL, no window, no library.
//
//   umbrage shaders normals,bitmask,denoise --language glsl -o KIT     # the build of the examples does this
//   opengl_ao KIT OUT                                                  # writes OUT.ppm, OUT_depth.pfm and OUT_ao.pfm
#define GL_GLEXT_PROTOTYPES
#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <GL/glcorearb.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "frame.h"  // of the kit: its uniform blocks

namespace {

constexpr int kWidth = 640, kHeight = 400;
constexpr float kNear = 0.1f, kFar = 100.0f, kTop = 0.45f;  // kTop: tan of half the vertical field of view

[[noreturn]] void fail(const std::string& why) {
  std::fprintf(stderr, "opengl_ao: %s\n", why.c_str());
  std::exit(1);
}

void open_context() {
  EGLDisplay display = eglGetPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
  if (!display) display = eglGetDisplay(EGL_DEFAULT_DISPLAY);
  if (!eglInitialize(display, nullptr, nullptr) || !eglBindAPI(EGL_OPENGL_API)) fail("EGL has no display");
  const EGLint wanted[] = {EGL_SURFACE_TYPE, EGL_PBUFFER_BIT, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_NONE};
  EGLConfig config = nullptr;
  EGLint count = 0;
  eglChooseConfig(display, wanted, &config, 1, &count);
  const EGLint version[] = {EGL_CONTEXT_MAJOR_VERSION, 4, EGL_CONTEXT_MINOR_VERSION, 3, EGL_NONE};  // core profile
  const EGLContext context = eglCreateContext(display, config, EGL_NO_CONTEXT, version);
  if (!context || !eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context)) fail("OpenGL 4.3 is missing");
}

std::string text_of(const std::string& file) {
  std::ifstream in(file);
  if (!in) fail(file + " cannot be read");
  return {std::istreambuf_iterator<char>(in), {}};
}

GLuint make_program(const std::string& vertex, const std::string& fragment) {
  const GLuint program = glCreateProgram();
  char log[4096] = "";
  GLint done = 0;
  for (const auto& [kind, text] : {std::pair(GL_VERTEX_SHADER, vertex), std::pair(GL_FRAGMENT_SHADER, fragment)}) {
    const GLuint shader = glCreateShader(kind);
    const char* lines = text.c_str();
    glShaderSource(shader, 1, &lines, nullptr);
    glCompileShader(shader);
    glGetShaderiv(shader, GL_COMPILE_STATUS, &done);
    glGetShaderInfoLog(shader, sizeof log, nullptr, log);
    if (!done) fail(log);
    glAttachShader(program, shader);
  }
  glLinkProgram(program);
  glGetProgramiv(program, GL_LINK_STATUS, &done);
  glGetProgramInfoLog(program, sizeof log, nullptr, log);
  if (!done) fail(log);
  return program;
}

GLuint make_texture(GLenum format) {
  GLuint texture = 0;
  glGenTextures(1, &texture);
  glBindTexture(GL_TEXTURE_2D, texture);
  glTexStorage2D(GL_TEXTURE_2D, 1, format, kWidth, kHeight);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  return texture;
}

struct Target {
  GLuint texture = 0, framebuffer = 0;
};

/// Makes a texture to draw to, with a depth buffer or none.
Target make_target(GLenum format, GLuint depth_buffer = 0) {
  Target target{make_texture(format)};
  glGenFramebuffers(1, &target.framebuffer);
  glBindFramebuffer(GL_FRAMEBUFFER, target.framebuffer);
  glFramebufferTexture(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, target.texture, 0);
  if (depth_buffer) glFramebufferTexture(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, depth_buffer, 0);
  if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) fail("a framebuffer is not complete");
  return target;
}

// --- The scene ---

/// Adds triangles of a box with these half sizes, or of the sphere in it: a grid on the sides of a cube.
void add_solid(std::vector<float>& mesh, const float (&center)[3], const float (&half)[3], bool box) {
  constexpr int kCells = 32, kCorners[6][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 0}, {1, 1}, {0, 1}};
  for (int side = 0; side < 6; ++side)
    for (int cell = 0; cell < kCells * kCells; ++cell)
      for (const auto& [i, j] : kCorners) {
        float n[3];  // a point of the cube from -1 to 1
        n[side / 2] = side % 2 ? 1.0f : -1.0f;
        n[(side / 2 + 1) % 3] = 2.0f * float(cell % kCells + i) / kCells - 1.0f;
        n[(side / 2 + 2) % 3] = 2.0f * float(cell / kCells + j) / kCells - 1.0f;
        const float scale = box ? 1.0f : 1.0f / std::hypot(n[0], n[1], n[2]);
        for (int k = 0; k < 3; ++k) mesh.push_back(center[k] + half[k] * n[k] * scale);
      }
}

/// Draws the scene, lit by a sky, with its depth buffer.
void draw_scene(const Target& picture) {
  std::vector<float> mesh;
  add_solid(mesh, {0, -0.1f, 0}, {7, 0.1f, 4}, true);  // the floor
  for (int k = 0; k < 5; ++k) {
    const float x = 1.6f * float(k - 2), r = 0.5f + 0.12f * float(k % 3), height = 0.3f + 0.2f * float(k);
    add_solid(mesh, {x, r, 0.3f * float(k % 2)}, {r, r, r}, false);
    add_solid(mesh, {x + 0.4f, height, -1.5f}, {0.55f, height, 0.55f}, true);
  }
  GLuint buffer = 0;
  glGenBuffers(1, &buffer);
  glBindBuffer(GL_ARRAY_BUFFER, buffer);
  glBufferData(GL_ARRAY_BUFFER, GLsizeiptr(mesh.size() * sizeof(float)), mesh.data(), GL_STATIC_DRAW);
  glEnableVertexAttribArray(0);
  glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, 0, nullptr);
  const GLuint program = make_program(R"(#version 430 core
    layout(location = 0) in vec3 position;
    uniform vec4 projection;  // its diagonal, and the depth's constant
    out vec3 at;
    void main() {
      const float c = cos(0.45), s = sin(0.45);  // the camera looks down -z and 0.45 radians downwards
      vec3 p = position - vec3(0.0, 3.4, 6.2);
      p = vec3(p.x, c * p.y - s * p.z, s * p.y + c * p.z);
      gl_Position = vec4(projection.xyz * p + vec3(0.0, 0.0, projection.w), -p.z);
      at = position;
    })",
                                      R"(#version 430 core
    in vec3 at;
    layout(location = 0) out vec4 light;
    void main() {
      vec3 n = normalize(cross(dFdx(at), dFdy(at)));
      light = vec4(mix(vec3(0.50, 0.42, 0.36), vec3(0.93, 0.92, 0.90), 0.5 + 0.5 * n.y) * (0.92 + 0.08 * n.x), 1.0);
    })");
  glUseProgram(program);
  glUniform4f(glGetUniformLocation(program, "projection"), kHeight / (kTop * kWidth), 1 / kTop,
              (kFar + kNear) / (kNear - kFar), 2 * kFar * kNear / (kNear - kFar));
  glBindFramebuffer(GL_FRAMEBUFFER, picture.framebuffer);
  glClearColor(0.42f, 0.52f, 0.64f, 1.0f);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  glEnable(GL_DEPTH_TEST);
  glDrawArrays(GL_TRIANGLES, 0, GLsizei(mesh.size() / 3));
  glDisable(GL_DEPTH_TEST);
}

// --- The passes ---

using Input = std::pair<const char*, GLuint>;  // a sampler's name, and its texture

/// Draws a triangle over all pixels of a target. A larger program looks up names once and keeps the buffers.
template <class Block>
void run(GLuint program, const Block& block, const std::vector<Input>& inputs, const Target& output) {
  glBindFramebuffer(GL_FRAMEBUFFER, output.framebuffer);
  glUseProgram(program);
  GLuint buffer = 0;
  glGenBuffers(1, &buffer);
  glBindBufferBase(GL_UNIFORM_BUFFER, 0, buffer);  // a shader has one block at most, whose binding is 0 by default
  glBufferData(GL_UNIFORM_BUFFER, sizeof block, &block, GL_STREAM_DRAW);
  for (std::size_t k = 0; k < inputs.size(); ++k) {
    glActiveTexture(GLenum(GL_TEXTURE0 + k));
    glBindTexture(GL_TEXTURE_2D, inputs[k].second);
    glUniform1i(glGetUniformLocation(program, inputs[k].first), GLint(k));
  }
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glDeleteBuffers(1, &buffer);
}

/// Writes a texture: colours as PPM, or one channel as PFM, whose lowest row is the first, as in OpenGL.
void save(const Target& target, const std::string& file, bool colors) {
  const std::size_t row = kWidth * (colors ? 3 : sizeof(float));  // bytes
  std::vector<char> texels(row * kHeight);
  glBindFramebuffer(GL_FRAMEBUFFER, target.framebuffer);
  glReadPixels(0, 0, kWidth, kHeight, colors ? GL_RGB : GL_RED, colors ? GL_UNSIGNED_BYTE : GL_FLOAT, texels.data());
  std::ofstream out(file, std::ios::binary);
  out << (colors ? "P6\n" : "Pf\n") << kWidth << ' ' << kHeight << (colors ? "\n255\n" : "\n-1.0\n");
  for (std::size_t y = 0; y < kHeight; ++y)
    out.write(&texels[row * (colors ? kHeight - 1 - y : y)], std::streamsize(row));
  if (!out.flush()) fail(file + " cannot be written");
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) fail("usage: opengl_ao KIT OUT");
  const std::string kit = argv[1], out = argv[2];
  open_context();
  GLuint vertices = 0;
  glGenVertexArrays(1, &vertices);
  glBindVertexArray(vertices);
  glViewport(0, 0, kWidth, kHeight);

  const GLuint depth_buffer = make_texture(GL_DEPTH_COMPONENT32F);
  const Target picture = make_target(GL_RGBA8, depth_buffer);
  draw_scene(picture);

  // One program per pass, and a texture for each plane.
  const std::string screen = text_of(kit + "/screen.vert");
  const auto pass = [&](const char* name) { return make_program(screen, text_of(kit + '/' + name + ".frag")); };
  const GLuint linear_depth = pass("linear_depth"), normals = pass("normals"), occlusion = pass("bitmask_occlusion"),
               across = pass("denoise_ao_across"), down = pass("denoise_ao_down");
  const Target depth = make_target(GL_R32F), normal = make_target(GL_RGBA16F), ao = make_target(GL_R32F),
               denoise_ao = make_target(GL_R32F), composed = make_target(GL_RGBA8);

  UmbrageView view = {};
  view.width = kWidth, view.height = kHeight;
  view.top = kTop, view.right = kTop * kWidth / kHeight;  // of a projection matrix P: 1 / P[1][1] and 1 / P[0][0]
  view.bottom = -view.top, view.left = -view.right;
  view.scene_radius = 8.0f;  // the radius of occlusion is 10 % of it, unless the kit was written with another --set

  const Input of_depth = {"depth_texture", depth.texture}, of_normal = {"normal_texture", normal.texture};
  const DepthFrame planes = depth_frame(kNear, kFar, 0);
  run(linear_depth, planes, {{"buffer_texture", depth_buffer}}, depth);
  run(normals, normals_frame(&view, 0), {of_depth}, normal);
  run(occlusion, bitmask_frame(&view, 0), {of_depth, of_normal}, ao);
  run(across, denoise_frame(&view, 0), {{"ao_texture", ao.texture}, of_depth, of_normal}, denoise_ao);
  run(down, denoise_frame(&view, 0), {{"denoise_ao_texture", denoise_ao.texture}, of_depth, of_normal}, ao);

  const GLuint compose = make_program(screen, R"(#version 430 core
    uniform sampler2D light_texture, ao_texture;
    layout(location = 0) out vec4 color;
    void main() {
      ivec2 at = ivec2(gl_FragCoord.xy);
      color = texelFetch(light_texture, at, 0) * texelFetch(ao_texture, at, 0).r;
    })");
  run(compose, planes, {{"light_texture", picture.texture}, {"ao_texture", ao.texture}}, composed);

  save(composed, out + ".ppm", true);
  save(depth, out + "_depth.pfm", false);
  save(ao, out + "_ao.pfm", false);
  if (const GLenum error = glGetError()) fail("OpenGL error " + std::to_string(error));
  std::printf("%s: %s\n", reinterpret_cast<const char*>(glGetString(GL_RENDERER)), (out + ".ppm").c_str());
}
