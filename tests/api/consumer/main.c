/* Simulates a ready scene of the installation. */
#include <cvtflow/cvtflow.h>
#include <stdio.h>

int main(void) {
    cvtflow_message message = CVTFLOW_INIT(cvtflow_message);
    cvtflow_scene* scene = NULL;
    cvtflow_simulation* simulation = NULL;
    if (cvtflow_scene_ready("tiny", &scene, &message) != CVTFLOW_OK || cvtflow_create(scene, NULL, &simulation, &message) != CVTFLOW_OK ||
        cvtflow_step(simulation, &message) != CVTFLOW_OK) {
        fprintf(stderr, "%s: %s\n", cvtflow_code_name(message.code), message.text);
        return 1;
    }
    printf("cvtflow %s: t = %g s, %zu unknowns\n", cvtflow_version(), cvtflow_time(simulation), cvtflow_size(simulation));
    cvtflow_destroy(simulation);
    cvtflow_scene_release(scene);
    return 0;
}
