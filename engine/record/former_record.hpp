#pragma once
/// A record that goes on: what an earlier run wrote up to a checkpoint, copied into the record of the run that continues it.
///
/// A file that HDF5 had open for writing when its process was killed is safe to read but not to write. So the rows are copied. At every
/// instant either `<path>.before` holds all rows up to the checkpoint, or the new `<path>.part` does, on disk.

#include <cstddef>
#include <string>
#include <vector>

#include "engine/record/run_file.hpp"

namespace cvtflow::engine {

/// How much of a record had been written at a checkpoint.
struct RecordPosition {
    std::size_t rows = 0;                ///< of channels
    std::size_t states = 0;
    std::vector<std::size_t> tables{};   ///< rows, in the order of RunContents
};

/// Copies the first rows of a record into a new one of the same contents, which is then flushed to disk.
/// Errors (RecordError): the former holds less than that, e.g. since it is another run's; other channels; damaged.
void copy_record(const std::string& former, const RecordPosition& until, const RunContents& contents, RunFile& file);

}  // namespace cvtflow::engine
