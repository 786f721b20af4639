#pragma once
/// Internal to engine/record: implementation of RunFile.

#include <chrono>
#include <string>
#include <string_view>
#include <vector>

#include "engine/record/run/part_file.hpp"
#include "engine/record/run/run_file.hpp"
#include "engine/record/run/run_layout.hpp"
#include "engine/record/table/row_block.hpp"

namespace cvtflow::engine {

struct RunFile::Impl {
    PartFile part;
    RunContents contents;
    RunFileOptions options;
    hdf5::RunLayout layout;
    hdf5::Handle file;
    hdf5::RowBlock channels;
    hdf5::RowBlock states;
    std::vector<hdf5::RowBlock> tables;
    std::vector<std::uint64_t> table_row;  ///< scratch: one row of the widest table
    std::size_t values_per_row = 0;
    double last_time = 0.0;   ///< of the last row taken [s]
    double saved_time = 0.0;  ///< of the last row written [s]
    std::chrono::steady_clock::time_point last_flush = std::chrono::steady_clock::now();
    std::vector<Attribute> late_attributes;
    std::string status;
    std::string damage;  ///< why HDF5 failed; nothing is written any more

    Impl(const Permit& permit, RunContents what, RunFileOptions how);
    void start();
    void require_open() const;
    void require_size(std::size_t given, std::size_t requested, std::string_view of) const;
    void make_room(std::size_t growth);
    [[noreturn]] void fail(const std::string& reason) const;
    /// Runs a call that writes; after a failure nothing is written any more.
    template <class Body>
    void or_damage(Body&& body);
    void write(hdf5::RowBlock& block);
    void prepare(hdf5::RowBlock& block);
    void flush();
    void finish(const std::string& final_status);
    void write_ending(const std::string& final_status);
    void release() noexcept;
};

}  // namespace cvtflow::engine
