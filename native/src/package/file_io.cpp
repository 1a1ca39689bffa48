// SPDX-License-Identifier: GPL-3.0-or-later
#include "package/file_io.h"

#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <charconv>
#include <cstring>

#include "base/error.h"

namespace ajar {
namespace {

namespace fs = std::filesystem;

const char* remedy(int error_number) {
    switch (error_number) {
        case ENOSPC:
        case EDQUOT:
        case EFBIG:
            return "Free some disk space or choose another output folder.";
        case EACCES:
        case EPERM:
        case EROFS:
            return "Choose an output folder that you may write to.";
        case ENOENT:
        case ENOTDIR:
            return "Choose an output folder whose parent exists and is a folder.";
        case ENAMETOOLONG:
            return "Choose a shorter output path.";
        case EMFILE:
        case ENFILE:
            return "Close other programs; the system has too many open files.";
        default:
            return "Check the disk or choose another output folder.";
    }
}

/// A file descriptor closed at the end of the scope.
class Descriptor {
public:
    Descriptor(const fs::path& path, int flags, const char* what) : fd_(::open(path.c_str(), flags | O_CLOEXEC, 0666)) {
        if (fd_ < 0) throw_io(what, path, errno);
    }
    ~Descriptor() {
        if (fd_ >= 0) ::close(fd_);
    }
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    int get() const { return fd_; }
    int close() {
        const int result = ::close(fd_);
        fd_ = -1;
        return result;
    }

private:
    int fd_;
};

void sync_directory(const fs::path& directory) {
    const Descriptor fd(directory, O_RDONLY | O_DIRECTORY, "open");
    if (::fsync(fd.get()) != 0 && errno != EINVAL) throw_io("write", directory, errno); // EINVAL: not supported there
}

/// "<name>.tmp-<pid>-<n>": the pid, or 0 if `entry` is not of that form.
pid_t owner_of_temporary(const std::string& entry, const std::string& name) {
    const std::string prefix = name + ".tmp-";
    if (entry.compare(0, prefix.size(), prefix) != 0) return 0;
    const char* end = entry.data() + entry.size();
    pid_t pid = 0;
    unsigned counter = 0;
    const auto first = std::from_chars(entry.data() + prefix.size(), end, pid);
    if (first.ec != std::errc() || first.ptr == end || *first.ptr != '-') return 0;
    const auto second = std::from_chars(first.ptr + 1, end, counter);
    return second.ec == std::errc() && second.ptr == end && pid > 0 ? pid : 0;
}

void remove_leftovers(const fs::path& parent, const std::string& name) {
    std::error_code ignored; // leftovers only cost space
    for (fs::directory_iterator it(parent, ignored), end; !ignored && it != end; it.increment(ignored)) {
        const pid_t pid = owner_of_temporary(it->path().filename().string(), name);
        if (pid == 0 || pid == ::getpid()) continue;
        if (::kill(pid, 0) != 0 && errno == ESRCH) {
            std::error_code failed;
            fs::remove_all(it->path(), failed);
        }
    }
}

/// A new directory beside the target; removed with all it holds when the scope ends.
class TemporaryDirectory {
public:
    TemporaryDirectory(const fs::path& parent, const std::string& name) {
        static std::atomic<unsigned> counter{0};
        for (;;) {
            path_ = parent / (name + ".tmp-" + std::to_string(::getpid()) + "-" + std::to_string(counter++));
            if (::mkdir(path_.c_str(), 0777) == 0) return;
            if (errno != EEXIST) throw_io("create", path_, errno);
        }
    }
    ~TemporaryDirectory() {
        std::error_code ignored;
        fs::remove_all(path_, ignored);
    }
    TemporaryDirectory(const TemporaryDirectory&) = delete;
    TemporaryDirectory& operator=(const TemporaryDirectory&) = delete;
    const fs::path& path() const { return path_; }

private:
    fs::path path_;
};

/// Exchanges both directories in one step; where the file system cannot, in two.
void exchange(const fs::path& fresh, const fs::path& target) {
    if (::renameat2(AT_FDCWD, fresh.c_str(), AT_FDCWD, target.c_str(), RENAME_EXCHANGE) == 0) return;
    if (errno != EINVAL && errno != ENOSYS && errno != EOPNOTSUPP) throw_io("replace", target, errno);
    const fs::path aside = fresh.string() + ".old";
    if (::rename(target.c_str(), aside.c_str()) != 0) throw_io("replace", target, errno);
    if (::rename(fresh.c_str(), target.c_str()) != 0) {
        const int reason = errno;
        ::rename(aside.c_str(), target.c_str());
        throw_io("replace", target, reason);
    }
    ::rename(aside.c_str(), fresh.c_str());
}

void put_in_place(const fs::path& fresh, const fs::path& target) {
    if (fs::exists(target)) {
        exchange(fresh, target);
    } else if (::rename(fresh.c_str(), target.c_str()) != 0) {
        throw_io("create", target, errno);
    }
    sync_directory(target.parent_path());
}

} // namespace

void throw_io(const std::string& what, const fs::path& path, int error_number) {
    throw Error(
        AJAR_ERROR_IO,
        "Cannot " + what + " \"" + path.string() + "\": " + std::strerror(error_number) + ". " + remedy(error_number),
        path.string());
}

void write_file(const fs::path& path, std::span<const uint8_t> bytes, bool synced) {
    Descriptor fd(path, O_WRONLY | O_CREAT | O_EXCL, "create");
    while (!bytes.empty()) {
        const ssize_t written = ::write(fd.get(), bytes.data(), bytes.size());
        if (written < 0 && errno == EINTR) continue;
        if (written <= 0) throw_io("write", path, written < 0 ? errno : ENOSPC);
        bytes = bytes.subspan(static_cast<size_t>(written));
    }
    if (synced && ::fsync(fd.get()) != 0) throw_io("write", path, errno);
    if (fd.close() != 0) throw_io("write", path, errno);
}

void write_file_synced(const fs::path& path, std::span<const uint8_t> bytes) { write_file(path, bytes, true); }

std::vector<uint8_t> read_file(const fs::path& path) {
    const Descriptor fd(path, O_RDONLY, "open");
    std::vector<uint8_t> bytes;
    for (uint8_t block[65536];;) {
        const ssize_t count = ::read(fd.get(), block, sizeof block);
        if (count < 0 && errno == EINTR) continue;
        if (count < 0) throw_io("read", path, errno);
        if (count == 0) return bytes;
        bytes.insert(bytes.end(), block, block + count);
    }
}

void replace_directory(const fs::path& directory, const std::function<void(const fs::path&)>& fill,
                       const std::function<void(const fs::path&, const fs::path*)>& accept_existing) {
    try {
        fs::path target = fs::weakly_canonical(fs::absolute(directory)); // a link is followed, not replaced
        if (!target.has_filename()) target = target.parent_path();
        const fs::path parent = target.parent_path();
        const std::string name = target.filename().string();
        if (name.empty()) throw_io("replace", directory, EPERM);
        if (fs::exists(target)) accept_existing(target, nullptr);
        fs::create_directories(parent);
        remove_leftovers(parent, name);
        const TemporaryDirectory temporary(parent, name);
        fill(temporary.path());
        if (fs::exists(target)) accept_existing(target, &temporary.path());
        sync_directory(temporary.path());
        put_in_place(temporary.path(), target);
    } catch (const fs::filesystem_error& e) {
        throw_io("write", e.path1().empty() ? directory : e.path1(), e.code().value());
    }
}

} // namespace ajar
