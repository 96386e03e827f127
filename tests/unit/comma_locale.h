/* comma_locale.h - a locale that writes 0,5 where this machine has one. */
#ifndef TEST_COMMA_LOCALE_H
#define TEST_COMMA_LOCALE_H

#include <locale.h>
#include <stdio.h>
#include <string.h>

/* 1 when such a locale is set now; setlocale(LC_ALL, "C") takes it back. */
static inline int set_comma_locale(void)
{
    static const char *const names[] = {"de_DE.UTF-8", "de_DE.utf8",         "de_DE",       "fr_FR.UTF-8",
                                        "fr_FR.utf8",  "nl_NL.UTF-8",        "ru_RU.UTF-8", "it_IT.UTF-8",
                                        "es_ES.UTF-8", "German_Germany.1252"};
    char text[8];

    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        if (setlocale(LC_ALL, names[i]) == NULL) continue;
        sprintf(text, "%.1f", 0.5);
        if (strcmp(text, "0,5") == 0) return 1;
    }
    setlocale(LC_ALL, "C");
    return 0;
}

#endif
