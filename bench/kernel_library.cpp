#include "kernel_library.h"

#include <dlfcn.h>

#include <stdexcept>

namespace carom_bench {
namespace {

// dlopen searches the system's folders for a name without a slash.
std::string as_path(const std::string& path) {
  return path.find('/') == std::string::npos ? "./" + path : path;
}

std::string last_error() {
  const char* text = dlerror();
  return text == nullptr ? "unknown error" : text;
}

}  // namespace

void KernelLibrary::Close::operator()(void* handle) const { dlclose(handle); }

KernelLibrary::KernelLibrary(const std::string& path)
    : path_(path), handle_(dlopen(as_path(path).c_str(), RTLD_NOW | RTLD_LOCAL)) {
  if (!handle_) throw std::runtime_error(path + ": cannot be loaded: " + last_error());
  const char* symbol = "carom_probe_collide";
  collide_ = need(find<CollideFunction>(symbol), symbol);
}

template <class Function>
Function KernelLibrary::find(const char* symbol) const {
  return reinterpret_cast<Function>(dlsym(handle_.get(), symbol));
}

template <class Function>
Function KernelLibrary::need(Function function, const char* symbol) const {
  if (function == nullptr) throw std::runtime_error(path_ + ": has no function " + symbol);
  return function;
}

BatchFunction KernelLibrary::batch() const {
  const char* symbol = "carom_probe_batch";
  return need(find<BatchFunction>(symbol), symbol);
}

StepsFunction KernelLibrary::steps() const {
  const char* symbol = "carom_probe_steps";
  return need(find<StepsFunction>(symbol), symbol);
}

TraceFunction KernelLibrary::trace() const {
  const char* symbol = "carom_trace";
  return need(find<TraceFunction>(symbol), symbol);
}

std::string KernelLibrary::kernel() const {
  const auto name = find<const char* (*)()>("carom_probe_kernel");
  return name == nullptr ? std::string() : name();
}

}  // namespace carom_bench
