#pragma once
/// Choices of how a step is cut into tasks. None of them changes a result.

namespace cvtflow::tasks {

enum class Assembly {
    fused,   ///< one task per segment and evaluation, joints at segment borders computed by both neighbours: a single synchronisation
    staged,  ///< the published schedule: separate tasks for every stage; of the laboratory (bench/staged)
};

enum class PartitionKind {
    equal,     ///< segments of equal numbers of links
    balanced,  ///< segments of about equal cost: links that touch a sheave cost more
};

}  // namespace cvtflow::tasks
