#include "tasks/step/method_memory.hpp"

#include <cmath>
#include <stdexcept>

namespace cvtflow::tasks {

std::span<const double> pop_front(std::span<const double>& memory, std::size_t count) {
    if (memory.size() < count) throw std::invalid_argument("the memory of the method is incomplete");
    const std::span<const double> numbers = memory.first(count);
    memory = memory.subspan(count);
    return numbers;
}

int pop_integer(std::span<const double>& memory, int first, int last) {
    const double number = pop_front(memory, 1)[0];
    if (!(number >= first && number <= last) || number != std::floor(number))
        throw std::invalid_argument("the memory of the method contains an invalid count");
    return static_cast<int>(number);
}

}  // namespace cvtflow::tasks
