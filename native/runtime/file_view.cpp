// SPDX-License-Identifier: Apache-2.0
#include "file_view.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "error.h"

namespace ajar::runtime {
namespace {

[[noreturn]] void throw_io(const char* what, const std::string& path) {
    throw Error(AJAR_RUNTIME_ERROR_IO, std::string("cannot ") + what + " \"" + path + "\": " + std::strerror(errno));
}

/// A file descriptor closed at the end of the scope.
struct Descriptor {
    int fd;
    explicit Descriptor(const std::string& path) : fd(::open(path.c_str(), O_RDONLY | O_CLOEXEC)) {
        if (fd < 0) throw_io("open", path);
    }
    ~Descriptor() { ::close(fd); }
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
};

} // namespace

FileView::FileView(const std::string& path, bool may_map) {
    const Descriptor file(path);
    struct stat info {};
    if (::fstat(file.fd, &info) != 0) throw_io("read", path);
    if (!S_ISREG(info.st_mode)) throw Error(AJAR_RUNTIME_ERROR_IO, "\"" + path + "\" is not a file");
    size_ = static_cast<size_t>(info.st_size);
    if (size_ == 0) return;
    void* const place = may_map ? ::mmap(nullptr, size_, PROT_READ | PROT_WRITE, MAP_PRIVATE, file.fd, 0) : MAP_FAILED;
    mapped_ = place != MAP_FAILED;
    if (mapped_)
        data_ = static_cast<uint8_t*>(place);
    else
        read(file.fd, path);
}

void FileView::read(int file, const std::string& path) {
    copy_.resize((size_ + 7) / 8);
    data_ = reinterpret_cast<uint8_t*>(copy_.data());
    for (size_t done = 0; done < size_;) {
        const ssize_t count = ::read(file, data_ + done, size_ - done);
        if (count < 0 && errno == EINTR) continue;
        if (count < 0) throw_io("read", path);
        if (count == 0) throw Error(AJAR_RUNTIME_ERROR_IO, "\"" + path + "\" became shorter while it was read");
        done += static_cast<size_t>(count);
    }
}

FileView::~FileView() {
    if (mapped_) ::munmap(data_, size_);
}

FileView::FileView(FileView&& other) noexcept { *this = std::move(other); }

FileView& FileView::operator=(FileView&& other) noexcept {
    std::swap(data_, other.data_);
    std::swap(size_, other.size_);
    std::swap(mapped_, other.mapped_);
    std::swap(copy_, other.copy_);
    return *this;
}

bool file_exists(const std::string& path) { return ::access(path.c_str(), F_OK) == 0; }

} // namespace ajar::runtime
