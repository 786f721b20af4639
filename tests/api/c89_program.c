/* The header and its initialisers in C89. */
#include <cvtflow/cvtflow.h>

int main(void) {
    cvtflow_message message = CVTFLOW_INIT(cvtflow_message);
    cvtflow_options options = CVTFLOW_INIT(cvtflow_options);
    cvtflow_counters counters = CVTFLOW_INIT(cvtflow_counters);
    cvtflow_channel_info info = CVTFLOW_INIT(cvtflow_channel_info);
    cvtflow_scene* scene = NULL;
    const int sizes = message.size == sizeof message && options.size == sizeof options && counters.size == sizeof counters && info.size == sizeof info;
    const int refused = cvtflow_scene_parse("[chain]\npins = 2\n", "c89.toml", &scene, &message) == CVTFLOW_SCENE;
    return sizes && refused && options.threads == 0 ? 0 : 1;
}
