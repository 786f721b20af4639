#include "engine/record/run/file_lock.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "engine/record/run/schema.hpp"

namespace cvtflow::engine {

/// An open-file-description lock: gone with the process, however it ends, and unseen by HDF5, which asks for flock locks.
bool try_lock(int descriptor, const std::string& path) {
    struct flock whole {};
    whole.l_type = F_WRLCK;
    whole.l_whence = SEEK_SET;
    int result = 0;
    do {
        result = fcntl(descriptor, F_OFD_SETLK, &whole);
    } while (result != 0 && errno == EINTR);
    if (result == 0) return true;
    if (errno == EAGAIN || errno == EACCES) return false;
    throw RecordError(path + ": cannot lock: " + std::strerror(errno) +
                      "; without a lock, two runs could write into it; use another file system");
}

}  // namespace cvtflow::engine
