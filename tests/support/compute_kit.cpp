// SPDX-License-Identifier: GPL-3.0-or-later
#include "compute_kit.h"

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <GL/glcorearb.h>

#include <stdexcept>

namespace kit {

namespace {

constexpr uint32_t kBindings = 8;

/// Entry points of OpenGL 4.3, looked up in the driver.
struct Functions {
    PFNGLGETSTRINGPROC get_string;
    PFNGLGETERRORPROC get_error;
    PFNGLCREATESHADERPROC create_shader;
    PFNGLSHADERSOURCEPROC shader_source;
    PFNGLCOMPILESHADERPROC compile_shader;
    PFNGLGETSHADERIVPROC get_shader;
    PFNGLGETSHADERINFOLOGPROC shader_log;
    PFNGLCREATEPROGRAMPROC create_program;
    PFNGLATTACHSHADERPROC attach_shader;
    PFNGLLINKPROGRAMPROC link_program;
    PFNGLGETPROGRAMIVPROC get_program;
    PFNGLGETPROGRAMINFOLOGPROC program_log;
    PFNGLUSEPROGRAMPROC use_program;
    PFNGLGENBUFFERSPROC gen_buffers;
    PFNGLBINDBUFFERPROC bind_buffer;
    PFNGLBINDBUFFERBASEPROC bind_buffer_base;
    PFNGLBUFFERDATAPROC buffer_data;
    PFNGLGETBUFFERSUBDATAPROC get_buffer;
    PFNGLDISPATCHCOMPUTEPROC dispatch;
    PFNGLMEMORYBARRIERPROC barrier;
    PFNGLFINISHPROC finish;
};

template <class F>
void look_up(F& function, const char* name) {
    function = reinterpret_cast<F>(eglGetProcAddress(name));
}

const Functions& gl() {
    static const Functions functions = [] {
        Functions f{};
        look_up(f.get_string, "glGetString");
        look_up(f.get_error, "glGetError");
        look_up(f.create_shader, "glCreateShader");
        look_up(f.shader_source, "glShaderSource");
        look_up(f.compile_shader, "glCompileShader");
        look_up(f.get_shader, "glGetShaderiv");
        look_up(f.shader_log, "glGetShaderInfoLog");
        look_up(f.create_program, "glCreateProgram");
        look_up(f.attach_shader, "glAttachShader");
        look_up(f.link_program, "glLinkProgram");
        look_up(f.get_program, "glGetProgramiv");
        look_up(f.program_log, "glGetProgramInfoLog");
        look_up(f.use_program, "glUseProgram");
        look_up(f.gen_buffers, "glGenBuffers");
        look_up(f.bind_buffer, "glBindBuffer");
        look_up(f.bind_buffer_base, "glBindBufferBase");
        look_up(f.buffer_data, "glBufferData");
        look_up(f.get_buffer, "glGetBufferSubData");
        look_up(f.dispatch, "glDispatchCompute");
        look_up(f.barrier, "glMemoryBarrier");
        look_up(f.finish, "glFinish");
        return f;
    }();
    return functions;
}

EGLDisplay open_display() {
    const auto get = reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(eglGetProcAddress("eglGetPlatformDisplayEXT"));
    if (get == nullptr) return EGL_NO_DISPLAY;
    return get(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
}

EGLContext make_context(EGLDisplay display) {
    if (eglBindAPI(EGL_OPENGL_API) == EGL_FALSE) return EGL_NO_CONTEXT;
    const EGLint wanted[] = {
        EGL_CONTEXT_MAJOR_VERSION,           4,       EGL_CONTEXT_MINOR_VERSION, 3, EGL_CONTEXT_OPENGL_PROFILE_MASK,
        EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL_NONE};
    return eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, wanted);
}

} // namespace

ComputeContext::ComputeContext() : buffers_(kBindings, 0), sizes_(kBindings, 0) {
    display_ = open_display();
    if (display_ == EGL_NO_DISPLAY || eglInitialize(display_, nullptr, nullptr) == EGL_FALSE) {
        display_ = EGL_NO_DISPLAY;
        missing_ = "EGL offers no display without a surface";
        return;
    }
    context_ = make_context(display_);
    if (context_ == EGL_NO_CONTEXT || eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_) == EGL_FALSE) {
        missing_ = "no driver offers OpenGL 4.3";
        return;
    }
    gl().gen_buffers(kBindings, buffers_.data());
}

ComputeContext::~ComputeContext() {
    if (display_ == EGL_NO_DISPLAY) return;
    eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    if (context_ != EGL_NO_CONTEXT) eglDestroyContext(display_, context_);
    eglTerminate(display_);
}

std::string ComputeContext::renderer() const { return reinterpret_cast<const char*>(gl().get_string(GL_RENDERER)); }

void ComputeContext::use(const std::string& source) {
    char log[4096] = "";
    GLint done = GL_FALSE;
    const char* text = source.c_str();
    const GLuint shader = gl().create_shader(GL_COMPUTE_SHADER);
    gl().shader_source(shader, 1, &text, nullptr);
    gl().compile_shader(shader);
    gl().get_shader(shader, GL_COMPILE_STATUS, &done);
    gl().shader_log(shader, sizeof log, nullptr, log);
    if (done != GL_TRUE) throw std::runtime_error(log);
    program_ = gl().create_program();
    gl().attach_shader(program_, shader);
    gl().link_program(program_);
    gl().get_program(program_, GL_LINK_STATUS, &done);
    gl().program_log(program_, sizeof log, nullptr, log);
    if (done != GL_TRUE) throw std::runtime_error(log);
    gl().use_program(program_);
}

void ComputeContext::fill(uint32_t binding, const uint32_t* words, size_t count) {
    const uint32_t nothing = 0;
    sizes_[binding] = count;
    gl().bind_buffer(GL_SHADER_STORAGE_BUFFER, buffers_[binding]);
    gl().buffer_data(GL_SHADER_STORAGE_BUFFER, static_cast<GLsizeiptr>(4 * std::max<size_t>(count, 1)),
                     count == 0 ? &nothing : words, GL_DYNAMIC_COPY);
    gl().bind_buffer_base(GL_SHADER_STORAGE_BUFFER, binding, buffers_[binding]);
}

std::vector<uint32_t> ComputeContext::read(uint32_t binding) const {
    std::vector<uint32_t> words(sizes_[binding]);
    gl().bind_buffer(GL_SHADER_STORAGE_BUFFER, buffers_[binding]);
    gl().get_buffer(GL_SHADER_STORAGE_BUFFER, 0, static_cast<GLsizeiptr>(4 * words.size()), words.data());
    return words;
}

void ComputeContext::dispatch(uint32_t groups) {
    if (groups != 0) gl().dispatch(groups, 1, 1);
    gl().barrier(GL_ALL_BARRIER_BITS);
    gl().finish();
    if (const GLenum error = gl().get_error(); error != GL_NO_ERROR)
        throw std::runtime_error("OpenGL error " + std::to_string(error));
}

} // namespace kit
