// SPDX-License-Identifier: Apache-2.0
#include "datasets/kitchen/gl_context.h"

#include <EGL/egl.h>
#include <EGL/eglext.h>

#include <array>

namespace engram::datasets::kitchen {

Result<std::unique_ptr<GlContext>> GlContext::create() {
  std::unique_ptr<GlContext> made(new GlContext);
  const auto get_display = reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(
      eglGetProcAddress("eglGetPlatformDisplayEXT"));
  if (get_display == nullptr)
    return unavailable("kitchen: EGL has no eglGetPlatformDisplayEXT; needs Mesa's libegl1");
  made->display_ = get_display(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
  if (made->display_ == EGL_NO_DISPLAY || eglInitialize(made->display_, nullptr, nullptr) == 0)
    return unavailable("kitchen: EGL cannot draw without a display (error {:#x}); needs Mesa",
                       eglGetError());
  if (eglBindAPI(EGL_OPENGL_API) == 0)
    return unavailable("kitchen: EGL has no OpenGL (error {:#x})", eglGetError());
  const std::array<EGLint, 5> wanted{EGL_SURFACE_TYPE, EGL_PBUFFER_BIT, EGL_RENDERABLE_TYPE,
                                     EGL_OPENGL_BIT, EGL_NONE};
  EGLConfig config = nullptr;
  EGLint found = 0;
  if (eglChooseConfig(made->display_, wanted.data(), &config, 1, &found) == 0 || found < 1)
    return unavailable("kitchen: EGL has no configuration with OpenGL (error {:#x})",
                       eglGetError());
  made->context_ = eglCreateContext(made->display_, config, EGL_NO_CONTEXT, nullptr);
  if (made->context_ == EGL_NO_CONTEXT)
    return unavailable("kitchen: EGL makes no OpenGL context (error {:#x})", eglGetError());
  if (eglMakeCurrent(made->display_, EGL_NO_SURFACE, EGL_NO_SURFACE, made->context_) == 0)
    return unavailable("kitchen: EGL needs a surface to draw (error {:#x})", eglGetError());
  return made;
}

GlContext::~GlContext() {
  if (display_ == nullptr) return;
  eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  if (context_ != nullptr) eglDestroyContext(display_, context_);
  eglTerminate(display_);
}

}  // namespace engram::datasets::kitchen
