// Which stock tangential models laws/law_styles.cpp combines with; read several times, so without a guard.
#include <tangential_model_history.h>
#include <tangential_model_no_history.h>
