#include "gl_kit.h"

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <GLES3/gl3.h>
#include <dlfcn.h>

#include <algorithm>

#include "core/check.h"

namespace umbrage::test {
namespace {

/// Functions of OpenGL, loaded by name.
template <class Function>
Function loaded(decltype(&eglGetProcAddress) load, const char* name) {
  return reinterpret_cast<Function>(load(name));
}
#define GL(name) (loaded<decltype(&gl##name)>(load, "gl" #name))

}  // namespace

struct GlContext::State {
  void* library = nullptr;
  decltype(&eglGetProcAddress) load = nullptr;
  EGLDisplay display = nullptr;
  EGLContext context = nullptr;
};

std::unique_ptr<GlContext> GlContext::make(bool is_es, std::string& reason) {
  auto state = std::make_unique<State>();
  state->library = ::dlopen("libEGL.so.1", RTLD_NOW | RTLD_NODELETE);
  reason = "libEGL.so.1 cannot be loaded";
  if (!state->library) return nullptr;
  const auto of = [&](const char* name) { return ::dlsym(state->library, name); };
  state->load = reinterpret_cast<decltype(&eglGetProcAddress)>(of("eglGetProcAddress"));
  const auto platform = reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(state->load("eglGetPlatformDisplayEXT"));
  reason = "EGL has no display without a window";
  if (!platform) return nullptr;
  state->display = platform(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
  if (!reinterpret_cast<decltype(&eglInitialize)>(of("eglInitialize"))(state->display, nullptr, nullptr))
    return nullptr;
  reinterpret_cast<decltype(&eglBindAPI)>(of("eglBindAPI"))(is_es ? EGL_OPENGL_ES_API : EGL_OPENGL_API);
  const EGLint wanted[] = {EGL_RENDERABLE_TYPE, is_es ? EGL_OPENGL_ES3_BIT : EGL_OPENGL_BIT, EGL_NONE};
  EGLConfig config = nullptr;
  EGLint count = 0;
  reinterpret_cast<decltype(&eglChooseConfig)>(of("eglChooseConfig"))(state->display, wanted, &config, 1, &count);
  const EGLint es[] = {EGL_CONTEXT_MAJOR_VERSION, 3, EGL_CONTEXT_MINOR_VERSION, 0, EGL_NONE};
  const EGLint core[] = {
      EGL_CONTEXT_MAJOR_VERSION,           4,       EGL_CONTEXT_MINOR_VERSION, 3, EGL_CONTEXT_OPENGL_PROFILE_MASK,
      EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL_NONE};
  state->context = reinterpret_cast<decltype(&eglCreateContext)>(of("eglCreateContext"))(
      state->display, config, EGL_NO_CONTEXT, is_es ? es : core);
  reason = "EGL makes no context of OpenGL 4.3 or OpenGL ES 3.0";
  if (!state->context) return nullptr;
  if (!reinterpret_cast<decltype(&eglMakeCurrent)>(of("eglMakeCurrent"))(state->display, EGL_NO_SURFACE, EGL_NO_SURFACE,
                                                                         state->context))
    return nullptr;
  std::unique_ptr<GlContext> result(new GlContext);
  result->state_ = std::move(state);
  return result;
}

GlContext::~GlContext() {
  const auto of = [&](const char* name) { return ::dlsym(state_->library, name); };
  reinterpret_cast<decltype(&eglMakeCurrent)>(of("eglMakeCurrent"))(state_->display, EGL_NO_SURFACE, EGL_NO_SURFACE,
                                                                    EGL_NO_CONTEXT);
  reinterpret_cast<decltype(&eglDestroyContext)>(of("eglDestroyContext"))(state_->display, state_->context);
}

namespace {

/// Runs the passes of one kit.
class Runner {
 public:
  Runner(decltype(&eglGetProcAddress) load_function, const Kit& kit) : load(load_function), kit_(kit) {}

  std::string run(const std::vector<std::vector<std::byte>>& blocks, std::map<std::string, Texels>& textures) {
    for (const auto& [name, texels] : textures) upload(name, texels);
    const std::string triangle = triangle_shader(kit_.language);
    GLuint array = 0;
    GL(GenVertexArrays)(1, &array);
    GL(BindVertexArray)(array);
    for (std::size_t k = 0; k < kit_.passes.size() && error_.empty(); ++k)
      draw(kit_.passes[k], blocks[k], triangle, textures);
    for (auto& [name, texture] : textures_) GL(DeleteTextures)(1, &texture.name);
    return error_;
  }

 private:
  struct Texture {
    GLuint name = 0;
    int width = 0, height = 0, channels = 1;
  };

  Texture made(int width, int height, int channels, const float* values) {
    Texture texture{0, width, height, channels};
    GL(GenTextures)(1, &texture.name);
    GL(BindTexture)(GL_TEXTURE_2D, texture.name);
    const bool is_one = channels == 1;
    GL(TexImage2D)
    (GL_TEXTURE_2D, 0, is_one ? GL_R32F : GL_RGBA32F, width, height, 0, is_one ? GL_RED : GL_RGBA, GL_FLOAT, values);
    GL(TexParameteri)(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    GL(TexParameteri)(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    return texture;
  }

  void upload(const std::string& name, const Texels& texels) {
    std::vector<float> values;  // row 0 at the bottom
    const int channels = texels.channels == 1 ? 1 : 4;
    for (int y = texels.height - 1; y >= 0; --y)
      for (int x = 0; x < texels.width; ++x)
        for (int c = 0; c < channels; ++c)
          values.push_back(
              c < texels.channels ? texels.values[std::size_t((y * texels.width + x) * texels.channels + c)] : 1.0f);
    textures_[name] = made(texels.width, texels.height, channels, values.data());
  }

  GLuint shader(GLenum stage, const std::string& text) {
    const GLuint made = GL(CreateShader)(stage);
    const char* source = text.c_str();
    GL(ShaderSource)(made, 1, &source, nullptr);
    GL(CompileShader)(made);
    GLint is_good = 0;
    GL(GetShaderiv)(made, GL_COMPILE_STATUS, &is_good);
    char log[1000] = "";
    if (!is_good) GL(GetShaderInfoLog)(made, sizeof log, nullptr, log);
    error_ += log;
    return made;
  }

  GLuint program(const std::string& file, const std::string& triangle) {
    const auto found = std::find_if(kit_.shaders.begin(), kit_.shaders.end(), [&](auto& f) { return f.name == file; });
    const GLuint made = GL(CreateProgram)();
    GL(AttachShader)(made, shader(GL_VERTEX_SHADER, triangle));
    GL(AttachShader)(made, shader(GL_FRAGMENT_SHADER, found->text));
    GL(LinkProgram)(made);
    GLint is_good = 0;
    GL(GetProgramiv)(made, GL_LINK_STATUS, &is_good);
    if (!is_good) error_ += file + " does not link";
    return made;
  }

  void draw(const KitPass& pass, const std::vector<std::byte>& block, const std::string& triangle,
            std::map<std::string, Texels>& textures) {
    const GLuint program_name = program(pass.file, triangle);
    if (!error_.empty()) return;
    GL(UseProgram)(program_name);
    GLuint buffer = 0;
    if (!block.empty()) {
      GL(GenBuffers)(1, &buffer);
      GL(BindBuffer)(GL_UNIFORM_BUFFER, buffer);
      GL(BufferData)(GL_UNIFORM_BUFFER, GLsizeiptr(block.size()), block.data(), GL_STATIC_DRAW);
      GL(BindBufferBase)(GL_UNIFORM_BUFFER, 0, buffer);
      GL(UniformBlockBinding)(program_name, 0, 0);
    }
    GL(ActiveTexture)(GL_TEXTURE0 + 15);  // made() binds its texture
    for (const std::string& name : pass.inputs)
      if (!textures_.count(name)) upload(name, neutral(name));
    for (std::size_t k = 0; k < pass.samplers.size(); ++k) {
      GL(ActiveTexture)(GLenum(GL_TEXTURE0 + k));
      GL(BindTexture)(GL_TEXTURE_2D, textures_[pass.inputs[k]].name);
      GL(Uniform1i)(GL(GetUniformLocation)(program_name, pass.samplers[k].c_str()), GLint(k));
    }
    const Texels& size = textures.at(pass.is_reduced ? "reduced size" : "size");
    GLuint frame = 0;
    GL(GenFramebuffers)(1, &frame);
    GL(BindFramebuffer)(GL_FRAMEBUFFER, frame);
    std::vector<GLenum> targets;
    std::vector<Texture> outputs;
    GL(ActiveTexture)(GL_TEXTURE0 + 15);
    for (const std::string& name : pass.outputs) {
      outputs.push_back(made(size.width, size.height, texture(name).channels == 1 ? 1 : 4, nullptr));
      targets.push_back(GLenum(GL_COLOR_ATTACHMENT0 + targets.size()));
      GL(FramebufferTexture2D)(GL_FRAMEBUFFER, targets.back(), GL_TEXTURE_2D, outputs.back().name, 0);
    }
    GL(DrawBuffers)(GLsizei(targets.size()), targets.data());
    if (GL(CheckFramebufferStatus)(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) error_ = pass.file + ": framebuffer";
    GL(Viewport)(0, 0, size.width, size.height);
    GL(DrawArrays)(GL_TRIANGLES, 0, 3);
    for (std::size_t k = 0; k < outputs.size(); ++k) {
      textures[pass.outputs[k]] = read(targets[k], outputs[k], texture(pass.outputs[k]).channels);
      if (textures_.count(pass.outputs[k])) GL(DeleteTextures)(1, &textures_[pass.outputs[k]].name);
      textures_[pass.outputs[k]] = outputs[k];
    }
    GL(DeleteFramebuffers)(1, &frame);
    GL(DeleteBuffers)(1, &buffer);
    GL(DeleteProgram)(program_name);
    if (const GLenum error = GL(GetError)()) error_ = fmt::format("{}: error {:#x}", pass.file, error);
  }

  const KitTexture& texture(const std::string& name) const {
    return *std::find_if(kit_.textures.begin(), kit_.textures.end(), [&](auto& t) { return t.name == name; });
  }

  Texels neutral(const std::string& name) const {
    const KitTexture& each = texture(name);
    return {1, 1, each.channels, std::vector<float>(std::size_t(each.channels), each.neutral)};
  }

  Texels read(GLenum target, const Texture& from, int channels) {
    std::vector<float> values(std::size_t(from.width) * from.height * 4);
    GL(ReadBuffer)(target);
    GL(ReadPixels)(0, 0, from.width, from.height, GL_RGBA, GL_FLOAT, values.data());
    Texels texels{from.width, from.height, channels, {}};
    for (int y = from.height - 1; y >= 0; --y)
      for (int x = 0; x < from.width; ++x)
        for (int c = 0; c < channels; ++c) texels.values.push_back(values[std::size_t((y * from.width + x) * 4 + c)]);
    return texels;
  }

  decltype(&eglGetProcAddress) load;
  const Kit& kit_;
  std::map<std::string, Texture> textures_;
  std::string error_;
};

}  // namespace

std::string GlContext::run(const Kit& kit, const std::vector<std::vector<std::byte>>& blocks,
                           std::map<std::string, Texels>& textures) {
  return Runner(state_->load, kit).run(blocks, textures);
}

}  // namespace umbrage::test
