#include "draw/window.h"

#include <GLES3/gl3.h>
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

namespace draw {
namespace {

std::string last_glfw_error() {
  const char* text = nullptr;
  glfwGetError(&text);
  return text != nullptr ? text : "no reason given";
}

GLFWwindow* create(const WindowOptions& options, int context_api) {
  glfwDefaultWindowHints();
  glfwWindowHint(GLFW_CLIENT_API, GLFW_OPENGL_ES_API);
  glfwWindowHint(GLFW_CONTEXT_CREATION_API, context_api);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 0);
  glfwWindowHint(GLFW_DEPTH_BITS, 0);
  glfwWindowHint(GLFW_STENCIL_BITS, 0);
  glfwWindowHint(GLFW_VISIBLE, options.visible ? GLFW_TRUE : GLFW_FALSE);
  GLFWmonitor* monitor = options.fullscreen ? glfwGetPrimaryMonitor() : nullptr;
  glm::ivec2 size = options.size;
  if (monitor != nullptr) {
    if (const GLFWvidmode* mode = glfwGetVideoMode(monitor)) size = {mode->width, mode->height};
  }
  return glfwCreateWindow(size.x, size.y, options.title.c_str(), monitor, nullptr);
}

}  // namespace

Window::Library::Library() : good(glfwInit() == GLFW_TRUE) {}
Window::Library::~Library() {
  glfwTerminate();
}
void Window::Destroy::operator()(GLFWwindow* handle) const {
  glfwDestroyWindow(handle);
}

Window::Window(std::unique_ptr<Library> library, GLFWwindow* handle)
    : library_(std::move(library)), handle_(handle) {}

tl::expected<Window, WindowError> Window::open(const WindowOptions& options) {
  auto library = std::make_unique<Library>();
  if (!library->good) {
    return tl::unexpected(WindowError{"No display to open a window on (" + last_glfw_error() +
                                      "): start it on a desktop, or set DISPLAY, or run it under "
                                      "xvfb-run, or " +
                                      options.otherwise + "."});
  }
  GLFWwindow* handle = create(options, GLFW_NATIVE_CONTEXT_API);
  if (handle == nullptr) handle = create(options, GLFW_EGL_CONTEXT_API);
  if (handle == nullptr) {
    return tl::unexpected(WindowError{
        "This display gives no OpenGL ES 3.0 (" + last_glfw_error() +
        "): install a driver (on Debian: apt-get install libgl1-mesa-dri libegl1 libgles2)."});
  }
  Window window(std::move(library), handle);
  glfwMakeContextCurrent(handle);
  glfwSwapInterval(1);
  return window;
}

bool Window::should_close() const {
  return glfwWindowShouldClose(handle_.get()) == GLFW_TRUE;
}

glm::ivec2 Window::size() const {
  glm::ivec2 size{0, 0};
  glfwGetFramebufferSize(handle_.get(), &size.x, &size.y);
  return size;
}

void Window::swap() {
  glfwSwapBuffers(handle_.get());
}

void Window::poll() {
  glfwPollEvents();
}

void Window::wait(double seconds) {
  glfwWaitEventsTimeout(seconds);
}

std::string Window::renderer() const {
  const auto* name = reinterpret_cast<const char*>(glGetString(GL_RENDERER));
  return name != nullptr ? name : "unknown";
}

bool Window::draws_in_software() const {
  for (const char* name : {"llvmpipe", "softpipe", "swrast", "SwiftShader", "Software"}) {
    if (renderer().find(name) != std::string::npos) return true;
  }
  return false;
}

}  // namespace draw
